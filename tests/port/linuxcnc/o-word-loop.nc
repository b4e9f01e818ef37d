; loop with o-words
G7 G18 G21 G90 G95
T1 M6
S700 M3
G0 X40 Z2
#<x> = 38
o100 while [#<x> GT 30]
G0 X#<x>
G1 Z-20 F0.2
G0 Z2
#<x> = [#<x> - 2]
o100 endwhile
M5
M2
