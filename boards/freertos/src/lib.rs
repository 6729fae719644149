//! Empty: the program is `main.c`.
