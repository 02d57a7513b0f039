"""The ground floor: parameters, errors, files, TOML, terminal, figures, pages."""
