; A contour as CAM writes it: corners, arcs and short chords, rounded inside 0.2 mm.
; Runs on the built-in machine (X, Y, Z; feed in mm/min). Try it with --slope hsc, and with G260 in N30.
%first
N10 G90 G17
N20 #CONTOUR MODE [DEV PATH_DEV=0.2]
N30 G261                     (corners become curves from here on)
N40 G01 X80 F15000
N50 X90 Y30
N60 G03 X70 Y50 I-20 J0      (an arc)
N70 G01 X60 Y60
N80 $FOR P1 = 1, 40, 1       (a wave of 40 short chords, faster and faster)
N90 X=60-P1 Y=60+4*SIN[18*P1] F=1000+50*P1
N100 $ENDFOR
N110 G02 X0 Y40 R20 F15000   (and another arc)
N120 G01 X0 Y0
N130 G260                    (corners as they are)
N140 G02 I15 J15             (full circle)
N150 M30
