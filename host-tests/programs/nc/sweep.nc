; A fan of strokes: the counter runs in steps of 7.5 degrees, block numbers follow it.
%sweep
P10 = 40 ( length of a stroke )
F3000
N1 G01 X-P10 Y0
$FOR P20 = 0, 90, 7.5
  N2 G01 X0 Y0
  P1 = COS[P20]*P10
  P2 = SIN[P20]*P10
  NP20 XP1 YP2
  N3 X-P10 Y0
$ENDFOR
$FOR P20 = 270, 370, 7.5
  N4 G01 X0 Y0
  NP20 X=P10*COS[P20] Y=P10*SIN[P20]
  N5 X-P10 Y0
$ENDFOR
M30
