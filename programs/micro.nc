( Lines of 1 to 50 micrometres on a circle of radius 100 mm, a thousand a second. )
%micro
N10 G90 G17 G01 X0 Y0 F1700
N20 #SLOPE [TYPE=HSC]
N30 P2 = 0
N40 $FOR P1 = 1, 3000, 1
N50 P2 = P2 + 0.0255 + 0.0245*SIN[P1*10]
N60 X=100*SIN[P2*0.572957795] Y=100-100*COS[P2*0.572957795]
N70 $ENDFOR
N80 M30
