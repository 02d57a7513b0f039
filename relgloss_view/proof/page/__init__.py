"""The page of a proof: its HTML, style, JavaScript and words, and what joins them."""
