; Two sharp knees, a wide arc and a narrow one: docs/plc.md sets the power of a laser from them.
N10 G01 X20 F3000
N20 Y15
N30 X35
N40 G03 X40 Y20 J5
N50 G01 Y40
N60 G02 X42 Y42 I2
N70 G01 X60
M30
