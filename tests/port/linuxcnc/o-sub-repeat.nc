; a groove three times by a subprogram, a repeated chamfer
o100 sub
G0 X32
G1 X26 F0.05
G4 P0.5
G0 X32
o100 endsub
G7 G18 G21 G90 G95
T1 M6
S700 M3
G0 X40 Z-10
o100 call
G0 Z-14
o100 call
o<pass> repeat [3]
G91
G0 Z-2
G90
o<pass> endrepeat
G0 X60 Z20
M5
M2
