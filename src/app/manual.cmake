# Writes man pages and bash completions of a built program from its help.
#
#   cmake -DPROGRAM=polhode -DVERSION=1.0 -DOUTPUT=directory -P manual.cmake
#
# writes OUTPUT/man1/polhode.1, OUTPUT/man1/polhode-COMMAND.1 and OUTPUT/completions/polhode.
cmake_minimum_required(VERSION 3.22)

string(ASCII 31 semicolon)

function(read_help variable)
  execute_process(COMMAND ${PROGRAM} ${ARGN} --help OUTPUT_VARIABLE text RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${PROGRAM} ${ARGN} --help: ${result}")
  endif()
  # CMake separates lists by semicolons: replace those in the text until it is written
  string(REPLACE ";" "${semicolon}" text "${text}")
  set(${variable} "${text}" PARENT_SCOPE)
endfunction()

# page(NAME TEXT SEE_ALSO): writes the printed help under the headings of a man page
function(page name text see_also)
  string(REGEX MATCH "^[^\n]+" first "${text}")
  string(REGEX REPLACE "^polhode: " "" first "${first}")
  foreach(part first text)
    string(REPLACE "\\" "\\e" ${part} "${${part}}")
    string(REPLACE "-" "\\-" ${part} "${${part}}")
    string(REGEX REPLACE "(^|\n)([.'])" "\\1\\\\&\\2" ${part} "${${part}}")
  endforeach()
  string(TOUPPER ${name} title)
  string(CONCAT page ".TH ${title} 1 \"\" \"polhode ${VERSION}\" \"User Commands\"
.SH NAME
${name} \\- ${first}
.SH DESCRIPTION
.nf
${text}
.fi
.SH SEE ALSO
${see_also}
")
  string(REPLACE "${semicolon}" ";" page "${page}")
  file(WRITE ${OUTPUT}/man1/${name}.1 "${page}")
endfunction()

read_help(top)
string(REGEX MATCH "Subcommands:\n.*" list "${top}")
string(REGEX MATCHALL "\n  [a-z]+ " commands "${list}")
string(REGEX REPLACE "[\n ]" "" commands "${commands}")
set(see_also "")
set(cases "")
foreach(command IN LISTS commands)
  list(APPEND see_also "polhode\\-${command}(1)")
  read_help(text ${command})
  page(polhode-${command} "${text}" "polhode(1)")
  string(REGEX MATCHALL "\n  [^ ][^ ]*" options "${text}")
  string(REGEX MATCHALL "--[a-z-]+" options "${options}")
  list(REMOVE_DUPLICATES options)
  list(JOIN options " " options)
  string(APPEND cases "        ${command}) options='${options}' ;;\n")
endforeach()
list(JOIN see_also ", " see_also)
page(polhode "${top}" "${see_also}")

list(JOIN commands " " commands)
file(WRITE ${OUTPUT}/completions/polhode "# bash completion of polhode
_polhode() {
    local current=\${COMP_WORDS[COMP_CWORD]} before=\${COMP_WORDS[COMP_CWORD - 1]} options= names=
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        COMPREPLY=(\$(compgen -W '${commands}' -- \"\$current\"))
        return
    fi
    case \${COMP_WORDS[1]} in
${cases}    esac
    if [[ \$before == --method ]]; then
        names=\$(\"\${COMP_WORDS[0]}\" list methods 2>/dev/null | cut -d' ' -f1)
    elif [[ \$current == -* ]]; then
        names=\$options
    elif [[ \${COMP_WORDS[1]} == run ]]; then
        names=\$(\"\${COMP_WORDS[0]}\" list experiments 2>/dev/null | cut -d' ' -f1)
    elif ((COMP_CWORD == 2)); then
        names=\$(\"\${COMP_WORDS[0]}\" list scenes 2>/dev/null | cut -d' ' -f1)
    fi
    COMPREPLY=(\$(compgen -W \"\$names\" -- \"\$current\"))
}
complete -o default -F _polhode polhode
")
