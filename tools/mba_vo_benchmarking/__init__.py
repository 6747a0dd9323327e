"""The parts of mba_vo_benchmark: an experiment file becomes runs, runs become figures, figures become pages."""
