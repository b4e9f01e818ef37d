O0003;
T0101 M03 S500;
G00 X30 Z2;
;G00 X32 Z3
G01 Z-20 F100 ; finish pass to shoulder
G00 X60 ;retract
M30;
