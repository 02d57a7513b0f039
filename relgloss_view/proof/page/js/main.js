// What runs when the page is opened.

window.relgloss = { ready: Promise.resolve() };
