add_program_test(verification box)
add_program_test(verification hertz)
