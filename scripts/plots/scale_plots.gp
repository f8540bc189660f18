# Plot of scale.dat in the current folder: scale.png. One bar a survey, its stages on one another.
load system("dirname " . ARG0) . "/bars.gp"
set style histogram rowstacked
set boxwidth 0.6
set output "scale.png"
set yrange [0:*]
set ylabel "CPU seconds a picture"
set title "The whole chain, CPU seconds (user + system) a picture"
plot for [stage in "features matching posing dense"] \
  "scale.dat" using (column(stage)):xtic(1) title stage
