; Lines, arcs by centre and by radius, a helix with a full turn, a wait, an exact stop, rapid motion.
%shapes
N10 G90 G00 X10 Y0 Z0
N20 G01 X50.125 F6000
N30 G02 X60.125 Y-10 I0 J-10
N40 G03 X70.125 Y0 R-10
N50 G01 Y20 G60
N60 G04 X0.05
N70 G03 X70.125 Y20 I-20 J0 Z3 F9000
N80 G18 G02 X70.125 Z3 I5 K0
N90 G00 X0 Y0 Z0
N100 M30
