; A contour as CAM writes it. Contour mode rounds its corners inside 0.2 mm, Surface smooths its chords inside
; 0.02 mm. Runs on the built-in machine (X, Y, Z; feed in mm/min); with --slope hsc it is faster.
%first
N10 G90 G17
N20 #CONTOUR MODE [DEV PATH_DEV=0.2]
N30 G261                     (corners become curves from here on)
N40 G01 X80 F15000
N50 X90 Y30
N60 G03 X70 Y50 I-20 J0      (an arc)
N70 G01 X60 Y60
N80 G260
N90 #HSC [SURFACE PATH_DEV=0.02]
N100 #HSC ON                 (chords become one smooth path)
N110 $FOR P1 = 1, 40, 1      (a wave of 40 of them)
N120 X=60-P1 Y=60+4*SIN[18*P1]
N130 $ENDFOR
N140 #HSC OFF
N150 G261
N160 G02 X0 Y40 R20          (and another arc)
N170 G01 X0 Y0
N180 G260                    (corners as they are)
N190 G02 I15 J15             (full circle)
N200 M30
