# What stands beside the installed program: pages of the manual, completion of shells and EDS files, which the program prints
# itself; examples, documentation, and a unit for systemd. So `cmake --install` runs the program: a build for another
# machine cannot be installed here.
install(CODE "execute_process(COMMAND \"${CMAKE_CURRENT_SOURCE_DIR}/tools/make-program-files\" \"$<TARGET_FILE:canopus>\"
                              \"${CMAKE_BINARY_DIR}/program-files\" \"${CANOPUS_PAGE}\" COMMAND_ERROR_IS_FATAL ANY)" COMPONENT program)
set(made ${CMAKE_BINARY_DIR}/program-files)
install(DIRECTORY ${made}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
install(FILES ${made}/canopus.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME canopus
        COMPONENT program)
install(FILES ${made}/_canopus DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT program)
install(FILES ${made}/canopus.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT program)
install(DIRECTORY ${made}/eds DESTINATION ${CMAKE_INSTALL_DATADIR}/canopus COMPONENT program)
install(FILES ${made}/canopus.cdx.json DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program OPTIONAL)
install(DIRECTORY examples docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program
        PATTERN state EXCLUDE PATTERN __pycache__ EXCLUDE PATTERN build EXCLUDE)
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
configure_file(packaging/canopus@.service.in ${CMAKE_BINARY_DIR}/canopus@.service @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/canopus@.service DESTINATION lib/systemd/system COMPONENT program)
install(DIRECTORY ${CANOPUS_PAGE}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/canopus/page COMPONENT program OPTIONAL)
