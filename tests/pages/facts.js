() => {
  const root = document.documentElement;
  const small = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const host = walker.currentNode.parentElement;
    if (!walker.currentNode.textContent.trim() || !host.checkVisibility()) continue;
    if (host.closest('script, style, noscript')) continue;
    const box = host.closest('svg');
    const matrix = box && host.getScreenCTM && host.getScreenCTM();
    const size = parseFloat(getComputedStyle(host).fontSize) * (matrix ? Math.hypot(matrix.a, matrix.b) : 1);
    if (size < 11.95) small.push(`${size.toFixed(1)} px: ${walker.currentNode.textContent.trim().slice(0, 40)}`);
  }
  return {
    nodes: document.querySelectorAll('*').length,
    screens: root.scrollHeight / innerHeight,
    overflow: root.scrollWidth - root.clientWidth,
    small,
    verdict: (document.querySelector('.verdict') || root).getBoundingClientRect().bottom / innerHeight,
  };
}
