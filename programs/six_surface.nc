( Chords over a dome with all six axes: three of the path, three rotary ones beside them, rounded as one surface. )
%six_surface
N10 G90 G17 G00 X0 Y0 Z0 A0 B0 C0
N20 #SLOPE [TYPE=HSC]
N30 #HSC ON [SURFACE PATH_DEV=0.05 TRACK_DEV=0.5]
N40 G01 F8000
N50 $FOR P1=1, 200, 1
N60 P2=P1*3.6
N70 X=P1*0.4 Y=6*SIN[P2] Z=4-4*COS[P2] A=8*SIN[2*P2] B=5-5*COS[P2] C=P1*0.3
N80 $ENDFOR
N90 #HSC OFF
N100 M30
