( Four axes: C moves along with lines and arcs, then alone, then fast enough to limit the path. )
%rotary
N10 G90 G17
N20 G01 X50 Y0 C45 F6000
N30 G03 X50 Y0 I-50 C405
N40 G01 X60 C500
N50 C320
N60 X100 Y40 Z10 C321
N70 G00 X0 Y0 Z0 C0
N80 M30
