( X carries a part past two obstacles, and keeps its speed: machine boards/host/machines/handling.toml. )
%handling
#CONTOUR MODE ON [DIST_MASTER SYM_DIST=-1]
N10 G01 X100 F20000
N20 X200 Y60
N30 X300 Y-10 Z30
N40 X400 Z0
N50 X500 Z40
N60 G260 X600 Y0 Z0
N70 M30
