%warm_up
(a square with rounded corners warms the spindle up until the PLC ends the loop; entry, repetition and exit are logged)
N10 G01 X10 F6000
N20 #CONTOUR MODE [DEV PATH_DEV=0.5]
N30 G261
N40 #CONTOUR LOOKAHEAD LOG ON [PARAM=1]
N50 #RT WHILE
N60 X30
N70 Y20
N80 X-10
N90 Y0
N100 X10
N110 #RT ENDWHILE
N120 #CONTOUR LOOKAHEAD LOG OFF
N130 X50
N140 G260
N150 M30
