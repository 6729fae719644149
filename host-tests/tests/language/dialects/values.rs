//! Programs with parameters, expressions, loops and subroutines, each compared with an equal program without
//! them.

/// The program, and what it comes to, worked out by hand.
pub const VALUES: &[(&str, &str)] = &[
    // Operators of one priority go from left to right; signs bind tightest.
    ("G0 X[2**3**2]", "G0 X64"),
    ("G0 X[-2**2] Y-[1+1] Z[1 - -2]", "G0 X4 Y-2 Z3"),
    ("G0 X[1+2*3] Y[[1+2]*3] Z[10-2-3]", "G0 X7 Y9 Z5"),
    ("G0 X[7 MOD 4] Y[-7 MOD 4] Z[8/4/2]", "G0 X3 Y1 Z1"),
    ("G0 X[1 EQ 1.0000001] Y[1 NE 1] Z[2 GT 1]", "G0 X1 Y0 Z1"),
    ("G0 X[1 GE 1] Y[1 LT 1] Z[1 LE 1]", "G0 X1 Y0 Z1"),
    ("G0 X[1 AND 0] Y[1 OR 0] Z[1 XOR 1]", "G0 X0 Y1 Z0"),
    ("G0 X[1+1 EQ 2 AND 3 GT 2]", "G0 X1"),
    ("G0 XFIX[-2.8] YFUP[-2.8] ZROUND[2.5]", "G0 X-3 Y-2 Z3"),
    ("G0 X[ABS[-3]+SQRT[16]] Y[SIN[30]*2] Z[COS[60]*4]", "G0 X7 Y1 Z2"),
    ("G0 X[ATAN[1]/[1]] Y[ATAN[1]/[-1]/3] Z[TAN[45]]", "G0 X45 Y45 Z1"),
    ("G0 X[ACOS[0]] Y[ASIN[1]/9] Z[EXP[0]+LN[1]]", "G0 X90 Y10 Z1"),
    ("G[80+10] G[0] X[1.5]", "G90 G0 X1.5"),
    ("G20 G0 X[0.5+0.5] F[10*2]\nG1 Y#1", "G20 G0 X1 F20\nG1 Y0"),
    // All parameters of a line are read before one is written.
    ("#3=6\n#3=15 G0 X#3\nX#3", "G0 X6\nX15"),
    ("#1=2 #2=7\nG0 X##1 Y#[1+1] Z-#1", "G0 X7 Y7 Z-2"),
    ("#<Depth Of Cut>=-2.5\n#<_all>=4\nG0 Z#<depthofcut> X[#<_ALL>+1]", "G0 Z-2.5 X5"),
    ("G0 X[EXISTS[#<a>]+10]\n#<a>=0\nX[EXISTS[#<a>]+20]", "G0 X10\nX21"),
    ("G0 X#999 Y5", "G0 X0 Y5"),
    ("G20\nG0 X2\nG21\nX[#5420+1] Y#5220", "G20\nG0 X2\nG21\nX51.8 Y1"),
    ("G54 G0 X3\nG91\nX#<_x> Y#<_incremental>", "G54 G0 X3\nG91\nX3 Y1"),
    ("o1 while [#1 LT 3]\n#1=[#1+1]\nG0 X#1\no1 endwhile\nX9", "G0 X1\nX2\nX3\nX9"),
    ("o1 do\n#1=[#1+1]\nG0 X#1\no1 while [#1 LT 2]\nX9", "G0 X1\nX2\nX9"),
    ("o1 repeat [2]\n#1=[#1+1] G0 X#1\no1 endrepeat", "G0 X0\nX1"),
    ("o1 repeat [0]\nG0 X1\no1 endrepeat\nG0 X5", "G0 X5"),
    (
        "o1 while [1]\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\no3 if [#1 GT 3]\no1 break\no3 endif\nG0 X#1\no1 endwhile\nY1",
        "G0 X1\nX3\nY1",
    ),
    (
        "o1 repeat [3]\n#1=[#1+1]\no2 if [#1 EQ 3]\no1 continue\no2 endif\nG0 X#1\no1 endrepeat\nY1",
        "G0 X1\nX2\nY1",
    ),
    (
        "o1 do\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nG0 X#1\no1 while [#1 LT 3]\nY1",
        "G0 X1\nX3\nY1",
    ),
    ("o1 if [0]\nG0 X1\no1 elseif [1]\nG0 X2\no1 elseif [1]\nG0 X3\no1 else\nG0 X4\no1 endif", "G0 X2"),
    ("o1 if [0]\nG0 X1\no1 else\nG0 X4\no1 endif\nY1", "G0 X4\nY1"),
    ("o<a> sub\nG0 X#1 Y#2 Z#3\no<a> endsub\n#1=8\no<A> call [1] [1+1]\nX#1", "G0 X1 Y2 Z0\nX8"),
    (
        "o1 sub\no2 if [#1 GT 1]\no1 return [#1*2]\no2 endif\nG0 X1\no1 endsub\no1 call [5]\nG0 X#<_value> Y#<_value_returned>\no1 call [0]\nG0 Y#<_value_returned>",
        "G0 X10 Y1\nX1\nY0",
    ),
    // A label beside `return` need not be that of the subroutine.
    (
        "o1 sub\no2 if [#1 GT 1]\no2 return [7]\no2 endif\nG0 X1\no1 endsub\no1 call [5]\nG0 Y#<_value>\no1 call [0]",
        "G0 Y7\nX1",
    ),
    ("G0 X#5599\n#5599=0\nY#5599 Z#<_task>", "G0 X1\nY0 Z1"),
    (
        "o1 sub\n#<i>=#1\nG0 X#<i>\no1 endsub\no2 sub\no1 call [#1+1]\no1 call [#1+2]\no2 endsub\no2 call [3]\no2 call [6]",
        "G0 X4\nX5\nX7\nX8",
    ),
    ("M98 P100 L2\nG90 G0 Y5\nM30\nO100\nG91 G0 X1\nM99", "G91 G0 X1\nX1\nG90 Y5\nM30"),
    (
        "%\nO1\nG0 X1 M98 P2\nX9\nM30\nO2 (two)\nM98 P3\nG0 Y2\nM99\nO3\nG0 Z3\nM99\n%",
        "%\nG0 X1\nZ3\nY2\nX9\nM30\n%",
    ),
    ("N10 o1 repeat [2]\n/N20 #1=[#1+1] G0 X#1\nN30 o1 endrepeat", "N20 G0 X0\nN20 X1"),
    ("G17 G2 X10 I5 K0 F100", "G17 G2 X10 I5 F100"),
];

/// Programs of Fanuc beside plain ones.
pub const FANUC: &[(&str, &str)] = &[
    ("G0 X10 Y1. Z-500", "G0 X0.01 Y1. Z-0.5"),
    ("G20\nG0 X10 Y1.\nG1 X5. F100", "G20\nG0 X0.001 Y1.\nG1 X5. F1."),
    ("G20 G0 X10000", "G20 G0 X1."),
    ("G2 X10. I5000 F100", "G2 X10. I5. F100"),
    ("G3 X10. R5000 F100", "G3 X10. R5. F100"),
    ("O1\nM98 P30100\nG90 G0 Y5.\nM30\nO0100\nG91 G0 X1.\nM99", "G91 G0 X1.\nX1.\nX1.\nG90 Y5.\nM30"),
    ("O1\nM98 P100 L2\nM30\n:100\nG91 G0 X1.\nM99", "G91 G0 X1.\nX1.\nM30"),
    (
        "O1\nM98 P0020200\nM30\n%\nO200\nG91 G0 X1.\nM98 P300\nM99\nO300\nG0 Y1.\nM99",
        "G91 G0 X1.\nY1.\nX1.\nY1.\nM30",
    ),
    ("G81 Z-5. R2000 F100\nG80\nX5.", "G81 Z-5. R2. F100\nG80\nG0 X5."),
    ("G83 X1. Z-5. R1. Q2000 F100", "G83 X1. Z-5. R1. Q2. F100"),
];

/// M70 to M73 in subroutines.
pub const STATE: &[(&str, &str)] = &[
    ("o1 sub\nM73\nG91 G20\nG0 X1\no1 endsub\nG90 G21\no1 call\nG0 X1", "G91 G20 G0 X1\nG90 G21 X1"),
    ("o1 sub\nM70\nG91\nG0 X1\nM72\nX5\no1 endsub\no1 call\nG0 X1", "G91 G0 X1\nG90 X5\nX1"),
    ("o1 sub\nM73\nM3 S5\no1 return\no1 endsub\no1 call\nG0 X1", "S5 M3\nS0\nM5\nG0 X1"),
    ("o1 sub\nM73\nG64 P0.5\nM71\no1 endsub\no1 call\nG0 X1", "G64 P0.5\nG0 X1"),
];
