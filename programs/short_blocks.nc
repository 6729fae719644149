( A wave of blocks of 0.25 mm and shorter, as CAM systems write them, at a feed no single block can reach. )
%short_blocks
N10 G90 G17
N20 G01 X0 Y0 F10000
N30 $FOR P1 = 1, 400, 1
N40 X=P1*0.25 Y=4*SIN[P1*1.8] Z=0.5*COS[P1*0.9]-0.5
N50 $ENDFOR
N60 $FOR P1 = 1, 100, 1
N70 X=100+P1*0.01
N80 $ENDFOR
N90 G00 X0 Y0 Z0
N100 M30
