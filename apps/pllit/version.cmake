# Writes OUTPUT with the version and the commit, where there is one.
set(commit "")
if(GIT)
  execute_process(COMMAND ${GIT} rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE commit
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    set(commit "")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT}
     CONTENT "#pragma once\n#define PLLIT_VERSION \"${VERSION}\"\n#define PLLIT_COMMIT \"${commit}\"\n")
