# Plots of mvs.dat in the current folder: mvs_cpu.png, mvs_f_score.png. One group a set, one bar a
# method; what could not run has none.
load system("dirname " . ARG0) . "/bars.gp"
stats "mvs.dat" using 0 nooutput
set xrange [-0.6:STATS_records - 0.4]
num_methods = int(system("wc -l < mvs_methods.txt"))
method(i) = system(sprintf("sed -n %dp mvs_methods.txt", i))

set output "mvs_cpu.png"
set yrange [0:*]
set ylabel "CPU seconds a megapixel"
set title "Densification, CPU seconds (user + system) a megapixel of picture"
plot for [i = 1:num_methods] "mvs.dat" using (column("cpu " . method(i))):xtic(1) title method(i)

set output "mvs_f_score.png"
set yrange [0:1]
set ylabel "F-score"
set title "F-score against our complete cloud (Tanks and Temples), middle distance"
plot for [i = 1:num_methods] "mvs.dat" using (column("f " . method(i))):xtic(1) title method(i)
