; The tip of a tool with C and A goes round a circle of short blocks. The tool trails by 30 degrees, and C follows.
; Machine: ca-head.toml. The feed counts along the tip; in the circle C binds the speed.
%tip
N10 #KIN ID[9]
N20 #TRAFO ON
N30 G00 A30 C0
N40 X40 Y0 Z5
N50 G01 Z0 F2000
N60 #HSC ON [SURFACE PATH_DEV=0.05]
N70 $FOR P1=1, 120, 1
N80 P2=P1*3
N90 X=40*COS[P2] Y=40*SIN[P2] C=P2 F12000
N100 $ENDFOR
N110 #HSC OFF
N120 G00 Z20
N130 #TRAFO OFF
N140 G00 A0 C0
N150 M30
