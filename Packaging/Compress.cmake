# SOURCE to TARGET by GZIP, without name and time, so that the same text gives the same file.
execute_process(COMMAND "${GZIP}" -9nc "${SOURCE}" OUTPUT_FILE "${TARGET}" COMMAND_ERROR_IS_FATAL ANY)
