"""Result files as tables of columns: text, numbers and how closely they are printed, layouts of the tools."""
