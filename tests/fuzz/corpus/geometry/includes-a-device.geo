Include "/dev/zero"
Merge "/dev/zero";
