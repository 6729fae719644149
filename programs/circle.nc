( A full circle of radius 80 mm with tangential lead-in and lead-out: what chords.nc tries to be. )
%circle
N10 G90 G17
N20 G01 X-80 Y0 F20000
N30 X0
N40 G03 X0 Y0 J80
N50 G01 X80
N60 M30
