O1982 (HOLES ON A CIRCLE)
(X Y centre, I radius, A first angle, B between, H how many, U the code of the hole)
N10 #33=#4003
N20 G90 G#21 Z#26 R#18 Q#17 F#9 K0
N30 WHILE [#11 GT 0] DO 1
N40 X[#24+#4*COS[#1]] Y[#25+#4*SIN[#1]]
N50 #1=#1+#2
N60 #11=#11-1
N70 END 1
N80 G80 G#33
N90 M99
