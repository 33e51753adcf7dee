add_program_test(programs ranks)
add_program_test(programs rods)
add_program_test(programs errors)
add_program_test(programs restart)
