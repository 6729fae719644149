( Drilling: rapid moves between feed moves, offsets, incremental dimensions, dwell at the bottom. )
%rapid_and_feed
N10 G17 G90
N20 G92 X10 Y10
N30 G00 X0 Y0 Z5
N40 $FOR P1 = 1, 5, 1
N50 G01 Z-4 F1200
N60 G04 X0.05
N70 G00 Z5
N80 G91 G00 X15 Y7.5
N90 G90
N100 $ENDFOR
N110 G01 X20 Y60 F30000
N120 X0.001
N130 X0
N140 G92 X0 Y0
N150 G00 X0 Y0 Z0
N160 M30
