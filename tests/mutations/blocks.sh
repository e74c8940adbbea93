# shellcheck shell=bash disable=SC2154 # $only and $shown are the scripts'
# Reads and applies mutations, for the scripts beside this file.

# Makes $copy, a copy of the working tree as far as git knows it; new times, so that cargo takes nothing of another copy for fresh.
copy_tree() {
    copy=$(mktemp -d)
    trap 'rm -rf "$copy"' EXIT
    git ls-files -z | tar --null --files-from=- --create --file=- 2>/dev/null | tar --extract --touch --file=- --directory="$copy"
    export CARGO_TARGET_DIR=${OUTMERGE_MUTATION_TARGET:-$copy/target}
    export CARGO_PROFILE_DEV_DEBUG=0
}

# Calls COMMAND NAME FILE FIND REPLACE WHERE for every block of a file: `@ name`, the source file, the text to find after `- `
# lines, its replacement after `+ ` lines, for some files `! where it must show`, and an empty line.
each_block() {
    local list=$1 command=$2 line name='' file='' find='' replace='' where=''
    while IFS= read -r line || [ -n "$line" ]; do
        case $line in
            '#'*) ;;
            '@ '*) name=${line#'@ '} file='' find='' replace='' where='' ;;
            '- '*) find+=${find:+$'\n'}${line#'- '} ;;
            '+ '*) replace+=${replace:+$'\n'}${line#'+ '} ;;
            '+') replace='' ;;
            '! '*) where=${line#'! '} ;;
            '') [ -z "$name" ] || "$command" "$name" "$file" "$find" "$replace" "$where"; name='' ;;
            *) file=$line ;;
        esac
    done <"$list"
    [ -z "$name" ] || "$command" "$name" "$file" "$find" "$replace" "$where"
}

# Changes a file in the copy: the first text that is FIND becomes REPLACE. Fails where there is none.
mutate() {
    local file=$1 find=$2 replace=$3 text
    text=$(cat "$file"; printf x)
    text=${text%x}
    [ "${text/"$find"/}" != "$text" ] || return 1
    printf '%s' "${text/"$find"/"$replace"}" >"$copy/$file"
}

# Puts a file of the copy back.
restore() { cp "$1" "$copy/$1" && touch "$copy/$1"; }

caught=0 survivors=() broken=()

# One mutation: changes the file in the copy, asks `probe WHERE` of the script, and puts the file back. A probe's status is 0 where
# nothing was noticed, 1 where something was, which it tells in $shown, else it could not be run.
check() {
    local name=$1 file=$2 find=$3 replace=$4 where=$5 status=0
    case $name in *"$only"*) ;; *) return 0 ;; esac
    mutate "$file" "$find" "$replace" || { broken+=("$name: its text is not in $file any more"); return 0; }
    probe "$where" || status=$?
    restore "$file"
    case $status in
        0) survivors+=("$name"); echo "SURVIVED  $name" ;;
        1) caught=$((caught + 1)); echo "caught    $name ($shown)" ;;
        *) broken+=("$name: status $status: $(grep -m1 '^error' "$copy/log" || tail -1 "$copy/log")") ;;
    esac
}

# Prints the counts, and fails unless all were caught.
verdict() {
    echo "$caught caught, ${#survivors[@]} survived, ${#broken[@]} could not be applied"
    local text
    for text in "${survivors[@]/#/survived: }" "${broken[@]/#/not applied: }"; do
        echo "$text"
    done
    [ ${#survivors[@]} -eq 0 ] && [ ${#broken[@]} -eq 0 ] && [ "$caught" -gt 0 ]
}
