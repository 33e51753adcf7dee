add_program_test(verification free_disk)
add_program_test(verification box)
add_program_test(verification hertz)
add_program_test(verification extremes)
