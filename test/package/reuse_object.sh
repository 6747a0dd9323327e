#!/bin/sh
# A compiler launcher: takes the object that BUILD has of a source of the package, in place of compiling it once more.
#
#   reuse_object.sh BUILD COMPILER ARGUMENT...
#
# Objects are told by their path below the build folder, as CMake makes it of target and source. What BUILD has not is compiled.
build=$1
shift

output=
dependencies=
previous=
for argument in "$@"; do
  case "$previous" in
    -o) output=$argument ;;
    -MF) dependencies=$argument ;;
  esac
  previous=$argument
done

case "$output" in
  */src/ros/intra_process_messages.cpp.o) ;;  # compiled: are the workspace's own messages found?
  CMakeFiles/*.o | CMakeFiles/*.gch)
    if [ -f "$build/$output" ]; then
      if [ -n "$dependencies" ]; then : >"$dependencies"; fi
      exec cp "$build/$output" "$output"
    fi
    ;;
esac
exec "$@"
