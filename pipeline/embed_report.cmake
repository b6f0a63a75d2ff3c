# cmake -DIN=report_template.html -DOUT=report_template.cc -P embed_report.cmake: the page's template as a C++ string.
# In pieces, as compilers need not take longer literals than 64 KiB.
file(READ ${IN} rest)
set(literals "")
while(NOT rest STREQUAL "")
  string(SUBSTRING "${rest}" 0 16000 piece)
  string(LENGTH "${piece}" length)
  string(SUBSTRING "${rest}" ${length} -1 rest)
  string(APPEND literals "R\"GLINT(${piece})GLINT\"\n")
endwhile()
file(WRITE ${OUT} "#include <string_view>\nnamespace glint {\nextern const std::string_view kReportTemplate;\n"
  "const std::string_view kReportTemplate =\n${literals};\n}\n")
