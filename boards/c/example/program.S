// The program: boards/tasks/tasks.nc.
    .section .rodata
    .global program, program_end
program:
    .incbin "tasks.nc"
program_end:
    .section .note.GNU-stack, "", %progbits
