; A polygon inside a circle, then the circle itself; the head turns with it.
%L polygon
N10 G01 X-P5 Y0 C-90 F2000   ( lead-in )
N20 X0
N30 $FOR P1 = 1, P3, 1
N40 P2 = P1*P4 F1500
N50 X=P5*SIN[P2] Y=P5*[1.0-COS[P2]] C[-90+P2]
N60 $ENDFOR
N70 XP5
M29

%L circle
N10 G01 X-P5 Y0 F2000
N20 X0
N30 G03 JP5                  ( full circle: no end point )
N40 G01 XP5
M29

%main
N100 P5 = 25   P3 = 16   P4 = 360/P3
N110 LL polygon
N120 LL circle
N130 M30
