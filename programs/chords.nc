( The circle of circle.nc as 64 chords: a knee of 5.625 degrees every 7.85 mm. )
%chords
N10 G90 G17
N20 P5 = 80
N30 P4 = 360/64
N40 G01 X-P5 Y0 F20000
N50 X0
N60 $FOR P1 = 1, 64, 1
N70 P2 = P1*P4
N80 X=P5*SIN[P2] Y=P5*[1-COS[P2]]
N90 $ENDFOR
N100 X=P5
N110 M30
