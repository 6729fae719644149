; A plate: its outline with rounded corners, a bore cut along a helix, a full circle to finish it.
; Runs on the built-in machine (X, Y, Z; feed in mm/min).
%plate
N10 G90 G17 G00 X20 Y0 Z5
N20 G01 Z-2 F3000            (down to the outline)
N30 G01 X180 F12000
N40 G03 X200 Y20 I0 J20      (corners by centre ...)
N50 G01 Y100
N60 G03 X180 Y120 I-20 J0
N70 G01 X20
N80 G03 X0 Y100 R20          (... and by radius)
N90 G01 Y20
N100 G03 X20 Y0 R20
N110 G00 Z5                  (over to the bore)
N120 G00 X135 Y60
N130 G01 Z0 F6000
N140 $FOR P1 = 1, 4, 1       (four turns of a helix, 2 mm each)
N150 G03 Z=-2*P1 I-35 F9000
N160 $ENDFOR
N170 G03 I-35 F15000         (full circle)
N180 G01 X100 Y60            (to the middle)
N190 G04 X0.25               (wait a quarter of a second)
N200 G00 Z20
N210 G00 X0 Y0 Z0
N220 M30
