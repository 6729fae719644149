//! Nothing: the program is `main.c`.
