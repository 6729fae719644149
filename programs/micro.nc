( Lines of 1 to 50 micrometres on a circle of radius 200 mm, a thousand a second. Two feeds by turns, so that none is merged. )
%micro
N10 G90 G17 G01 X0 Y0 F1700
N20 #SLOPE [TYPE=HSC]
N30 P2 = 0
N40 $FOR P1 = 1, 1500, 1
N50 P2 = P2 + 0.0255 + 0.0245*SIN[P1*20]
N60 X=200*SIN[P2*0.286478898] Y=200-200*COS[P2*0.286478898] F1700
N70 P2 = P2 + 0.0255 + 0.0245*SIN[P1*20+10]
N80 X=200*SIN[P2*0.286478898] Y=200-200*COS[P2*0.286478898] F1700.01
N90 $ENDFOR
N100 M30
