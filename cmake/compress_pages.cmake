# cmake -DGZIP=gzip -DFOLDER=man1 -P compress_pages.cmake: each page in the folder, without name or time in it.
file(GLOB pages ${FOLDER}/*.1)
foreach(page IN LISTS pages)
  execute_process(COMMAND ${GZIP} -9nf ${page} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
