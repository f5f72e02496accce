"""What views and panels are drawn with: the page's scene, colours, images, and viser's private parts."""
