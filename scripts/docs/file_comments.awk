# Changes the comments of a header for doxygen: the comment before the namespace becomes that of the file,
# and a first sentence does not end after an initial or an abbreviation.
/^ *\/\/\// {
  while (match($0, /(Eq|Eqs|Fig|Sec|No|e\.g|i\.e|[ (][A-Z])\. /))
    $0 = substr($0, 1, RSTART + RLENGTH - 2) "\\ " substr($0, RSTART + RLENGTH)
}
/^\/\/\// { held = held $0 "\n"; next }
held != "" { if (/^namespace/) printf "/// \\file\n"; printf "%s", held; held = "" }
{ print }
END { printf "%s", held }
