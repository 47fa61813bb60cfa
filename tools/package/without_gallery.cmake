# Run at the installation of the pages: they stand without the pictures of the gallery, which are half of a package (14 MB); their
# words stay.
file(GLOB_RECURSE files "$ENV{DESTDIR}${pages}/*.md")
foreach(file ${files})
  file(READ ${file} text)
  string(REGEX REPLACE "<img src=\"[^\"]*gallery/[^\"]*\"[^>]*>" "" text "${text}")
  string(REGEX REPLACE "!\\[([^]]*)\\]\\([^)]*gallery/[^)]*\\)" "*\\1.*" text "${text}")
  string(REGEX REPLACE "\\[([^]]*)\\]\\([^)]*gallery/[^)]*\\)" "\\1" text "${text}")
  file(WRITE ${file} "${text}")
endforeach()
