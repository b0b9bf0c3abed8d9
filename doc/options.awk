# options.awk: puts a command's options and example, as its --help (first file) has them, in place of the line
# @OPTIONS@ of its manual page (second file, scdoc).
function escape(s) {
    gsub(/[\\*_`]/, "\\\\&", s)
    return s
}
function flush() {
    if (item != "") {
        text = text "*" item "*" (value != "" ? " " value : "") "\n\t" about "\n\n"
    }
    item = ""
}
FNR == 1 { file++ }
file == 1 && example != "" { example = example $0 "\n"; next }
file == 1 && /^Example/ { flush(); example = "\n"; next }
file == 1 && /^  --/ {
    flush()
    if (heading != "") {
        text = text "## " toupper(heading) "\n\n"
        heading = ""
    }
    match($0, /  --[^ ]+/)
    item = escape(substr($0, 3, RLENGTH - 2))
    rest = substr($0, RLENGTH + 1)
    value = about = ""
    if (rest ~ /^ [^ ]/) { # a value, and then the text unless that is on the next line
        sub(/^ /, "", rest)
        cut = match(rest, /  +| [^ ]+$/) && rest ~ /  / ? index(rest, "  ") : length(rest) + 1
        value = escape(substr(rest, 1, cut - 1))
        rest = substr(rest, cut)
    }
    sub(/^ +/, "", rest)
    about = escape(rest)
    next
}
file == 1 && item != "" && /^ / {
    sub(/^ +/, "")
    about = about (about != "" ? " " : "") escape($0)
    next
}
file == 1 { heading = $0; next }
$0 == "@OPTIONS@" {
    flush()
    printf "# OPTIONS\n\n%s# EXAMPLE\n\n```%s```\n", text, example
    next
}
{ print }
