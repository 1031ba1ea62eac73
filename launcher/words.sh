# The user's language, for ../course, which reads this file: any sh can, before there is a Python. words.py is the same
# for what Python says. Needs root, the course's folder.
# shellcheck shell=sh
# shellcheck disable=SC2154 # root is set in course

# Sets COURSE_WORDS to the catalogue of the language that an argument, a lesson's terminal or the locale names, the first
# of them that there is; to '' for English. launcher/words.py reads it, too.
find_words() {
    asked='' before='' locale=${LC_ALL:-${LC_MESSAGES:-${LANG:-}}} COURSE_WORDS=''
    export COURSE_WORDS
    for argument; do
        case $before$argument in --language=*) asked=${argument#*=} ;; --language?*) asked=$argument ;; esac
        before=; [ "$argument" != --language ] || before=$argument
    done
    for language in "$asked" "${COURSE_LANGUAGE:-}" "${locale%%[.@]*}"; do
        case $language in en | en_*) return ;; '' | */*) continue ;; esac
        for found in "$root/locale/$language" "$root/locale/${language%%_*}"_*; do
            [ -f "$found/LC_MESSAGES/launcher.po" ] || continue
            COURSE_WORDS=$found/LC_MESSAGES/launcher.po
            return
        done
    done
}

# Translates lines: a whole one, or what stands behind two spaces in it, as in the table of the verbs.
# shellcheck disable=SC2016 # the expressions are awk's
translate='
function text(line) {
    sub(/^[a-z]* *"/, "", line); sub(/"$/, "", line); gsub(/\\"/, "\"", line)
    return line
}
function keep() { if (id != "" && value != "" && !fuzzy) known[id] = value }
BEGIN {
    while ((getline line <ENVIRON["COURSE_WORDS"]) > 0) {
        if (line ~ /^#,.*fuzzy/) next_is_fuzzy = 1
        if (line ~ /^msgid /) { keep(); fuzzy = next_is_fuzzy; next_is_fuzzy = 0; id = text(line); value = "" }
        if (line ~ /^msgstr /) value = text(line)
    }
    keep()
}
{
    last = ($0 in known) ? $0 : part[split($0, part, /  +/)]
    print substr($0, 1, length($0) - length(last)) ((last in known) ? known[last] : last)
}
'
in_words() {
    if [ -n "$COURSE_WORDS" ] && command -v awk >/dev/null; then
        LC_ALL=C awk "$translate"
    else
        cat
    fi
}

# put SENTENCE [NAME VALUE]...: prints it in the user's language, with each value in the place of its name.
put() {
    sentence=$(printf '%s\n' "$1" | in_words)
    shift
    while [ $# -gt 1 ]; do
        sentence=${sentence%%"{$1}"*}$2${sentence#*"{$1}"}
        shift 2
    done
    printf '%s\n' "$sentence"
}
